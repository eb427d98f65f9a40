!> The rock's own pressure at the nodes of the mesh, for windows.
!!
!! Next to a fracture the pressure may change from that of the fluid to that of the rock within a
!! layer that is thinner than a cell. A gradient that ends at the fluid's pressure distributes such
!! a layer over the cell: with fluid and rock 7 MPa apart, the resulting back stress closed a crack
!! of 100 m. Here the pressure follows from the means of the cells alone, on each side of a fracture
!! separately, so that it jumps at the face if the layer is thinner than a cell.
module coarse_own_pressure
   use base_kinds, only: ik, rk
   use mesh_geometry, only: cell_centre
   use mesh_types, only: mesh_t
   implicit none(type, external)
   private

   public :: own_pressure

   !> Of the determinant of a patch's second moments over its largest value: below, the centres of
   !! its cells lie in a line and give no gradient [-].
   real(rk), parameter :: flat_patch = 1.0e-6_rk

contains

   !> Pressure at nodes: the mean of the adjacent cells plus the smaller of two extrapolations
   !! (minmod), one with the gradient of the cells' means, one that contains the fluid's pressure at
   !! faces. Exact for linear pressures.
   pure function own_pressure(mesh, means, extrapolated) result(values)
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: means(:)  !< (n_cells) [Pa]
      real(rk), intent(in) :: extrapolated(:)  !< (n_nodes) of coarse_nodes [Pa]
      real(rk), allocatable :: values(:)  !< (n_nodes) [Pa]
      real(rk), allocatable :: gradients(:, :), plain(:), weight(:)
      integer(ik) :: c, k, v

      gradients = gradients_of_means(mesh, means)
      allocate (values(mesh%n_nodes), plain(mesh%n_nodes), weight(mesh%n_nodes), source=0.0_rk)
      do c = 1, mesh%n_cells
         do k = 1, 3
            v = mesh%cell_nodes(k, c)
            plain(v) = plain(v) + means(c)
            values(v) = values(v) + dot_product(gradients(:, c), mesh%xy(:, &
                                                                         v) - cell_centre(mesh, c))
            weight(v) = weight(v) + 1.0_rk
         end do
      end do
      plain = plain/weight
      values = plain + minmod(values/weight, extrapolated - plain)
   end function own_pressure

   !> Gradient in each cell, by least squares through the cells that share a node with it.
   pure function gradients_of_means(mesh, means) result(gradients)
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: means(:)  !< (n_cells) [Pa]
      real(rk) :: gradients(2, mesh%n_cells)  !< [Pa/m]
      !> (n_nodes) sums over the cells around: their number, offsets of their centres from the node,
      !! products of these, pressures relative to one of them, products of those with the offsets
      real(rk), allocatable :: moments(:, :)
      real(rk) :: around(9), offset(2), p
      integer(ik) :: c, k, v

      allocate (moments(9, mesh%n_nodes), source=0.0_rk)
      do c = 1, mesh%n_cells
         p = means(c) - means(1)
         do k = 1, 3
            v = mesh%cell_nodes(k, c)
            offset = cell_centre(mesh, c) - mesh%xy(:, v)
            moments(:, v) = moments(:, v) + [1.0_rk, offset, offset(1)**2, product(offset), &
                                             offset(2)**2, p, p*offset]
         end do
      end do
      do c = 1, mesh%n_cells
         around = 0.0_rk
         do k = 1, 3
            v = mesh%cell_nodes(k, c)
            around = around + shifted(moments(:, v), mesh%xy(:, v) - cell_centre(mesh, c))
         end do
         gradients(:, c) = gradient_of(around)
      end do
   end function gradients_of_means

   !> Moments about another point.
   pure function shifted(m, by) result(moments)
      real(rk), intent(in) :: m(9)
      real(rk), intent(in) :: by(2)  !< the old point from the new one [m]
      real(rk) :: moments(9)

      moments = [m(1), m(2:3) + m(1)*by, m(4) + 2.0_rk*m(2)*by(1) + m(1)*by(1)**2, &
                 m(5) + m(2)*by(2) + m(3)*by(1) + m(1)*product(by), &
                 m(6) + 2.0_rk*m(3)*by(2) + m(1)*by(2)**2, m(7), m(8:9) + m(7)*by]
   end function shifted

   !> Gradient of the least-squares plane; zero if the points lie on a line.
   pure function gradient_of(m) result(gradient)
      real(rk), intent(in) :: m(9)
      real(rk) :: gradient(2), xx, xy, yy, right(2), determinant

      xx = m(4) - m(2)**2/m(1)
      xy = m(5) - m(2)*m(3)/m(1)
      yy = m(6) - m(3)**2/m(1)
      right = m(8:9) - m(7)*m(2:3)/m(1)
      determinant = xx*yy - xy**2
      gradient = 0.0_rk
      if (determinant <= flat_patch*(xx + yy)**2) return
      gradient = [yy*right(1) - xy*right(2), xx*right(2) - xy*right(1)]/determinant
   end function gradient_of

   !> The smaller of two numbers of the same sign, else 0.
   elemental real(rk) function minmod(a, b)
      real(rk), intent(in) :: a, b

      minmod = 0.0_rk
      if (a*b > 0.0_rk) minmod = sign(min(abs(a), abs(b)), a)
   end function minmod

end module coarse_own_pressure
