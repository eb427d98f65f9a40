!> Chains of volumes against closed forms of the half-space: a constant scalar at the face, a
!! constant flux, and a constant supply to a face that stores too; steady flow, balance, symmetry.
program test_coarse_chain
   use base_kinds, only: pi, rk
   use coarse_chain, only: chain_t, new_chain, node_count
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: thickness = 1.0_rk, length = 2.0_rk  !< [m]
   real(rk), parameter :: conductivity = 3.0e-16_rk  !< [m2/(Pa s)]
   real(rk), parameter :: storage = 5.0e-11_rk  !< [1/Pa]
   real(rk), parameter :: diffusivity = conductivity/storage
   real(rk), parameter :: first(3) = [0.02_rk, 2.0e-3_rk, 1.0e-4_rk]  !< first volumes [m]
   !> Times of comparison: the layer has so many thicknesses of the first volume, to so many
   !! thicknesses of the chain.
   real(rk), parameter :: from = 2.0_rk, to = 0.3_rk
   integer, parameter :: given_scalar = 1, given_flux = 2, given_supply = 3
   type(checks_t) :: checks
   integer :: i

   do i = 1, size(first)
      call test_sums(first(i))
      call test_steady(first(i))
      call compare(first(i), given_scalar, "constant scalar")
      call compare(first(i), given_flux, "constant flux")
      call compare(first(i), given_supply, "constant supply to a face that stores")
   end do
   call checks%is_true(all(node_count(1.0_rk, [0.1_rk, 4.0e-3_rk, 1.0e-4_rk]) == [6, 8, 10]), &
                       "number of nodes")
   call test_sums(thickness)  ! not to be had: the volumes are equal
   call checks%finish()

contains

   !> The volumes fill the layer; resistances add up; the elimination is symmetric.
   subroutine test_sums(first_volume)
      real(rk), intent(in) :: first_volume  !< [m]
      type(chain_t) :: chain

      chain = new_chain(thickness, first_volume, length, conductivity, storage)
      call chain%prepare(1.0e3_rk)
      associate (n => chain%n, g => chain%conductance)
         call checks%is_close(sum(chain%volume), thickness*length, 1.0e-12_rk, "volume")
         call checks%is_close(sum(1.0_rk/g)*length*conductivity, chain%place(n), 1.0e-12_rk, &
                              "resistance")
         call checks%is_true(all(chain%volume(2:)/chain%volume(:n - 1) < 4.0_rk), "ratio")
        call checks%is_close(g(0)*chain%beta(1)/(g(n - 1)*chain%alpha(n - 1)), 1.0_rk, 1.0e-12_rk, &
                              "symmetry of both ends")
         call checks%is_close(dot_product(chain%volume(:n - 1), chain%alpha) &
                              /(1.0e3_rk*g(0)*chain%gamma(1)), 1.0_rk, 1.0e-12_rk, &
                              "symmetry of mu and the face")
         call checks%is_close(dot_product(chain%volume(:n - 1), chain%beta) &
                              /(1.0e3_rk*g(n - 1)*chain%gamma(n - 1)), 1.0_rk, 1.0e-12_rk, &
                              "symmetry of mu and the outer end")
      end associate
   end subroutine test_sums

   !> After a step longer than all times of the layer the flux is that of the resistance alone.
   subroutine test_steady(first_volume)
      real(rk), intent(in) :: first_volume  !< [m]
      type(chain_t) :: chain
      real(rk), allocatable :: p(:)

      chain = new_chain(thickness, first_volume, length, conductivity, storage)
      call chain%prepare(1.0e12_rk*thickness**2/diffusivity)
      p = chain%inner(chain%stored(spread(0.3_rk, 1, int(chain%n) - 1)), 0.0_rk, 1.0_rk, 0.5_rk)
      call checks%is_close(chain%conductance(0)*(1.0_rk - p(1)) &
                           /(0.5_rk*conductivity*length/chain%place(chain%n)), 1.0_rk, 1.0e-7_rk, &
                           "steady flux")
   end subroutine test_steady

   !> The chain, closed at its outer end, in short steps from rest.
   subroutine compare(first_volume, kind, name)
      real(rk), intent(in) :: first_volume  !< [m]
      integer, intent(in) :: kind  !< of the condition at the face
      character(len=*), intent(in) :: name
      real(rk), parameter :: growth = 1.02_rk, tolerance = 0.03_rk
      type(chain_t) :: chain
      real(rk), allocatable :: p(:), rho(:)
      real(rk) :: dt, exact, face, found, held, inflow, largest, rows(2, 2), rhs(2), time, width

      chain = new_chain(thickness, first_volume, length, conductivity, storage)
      allocate (p(chain%n), source=0.0_rk)
      dt = 1.0e-3_rk*first_volume**2/diffusivity
      time = 0.0_rk
      face = 0.0_rk
      inflow = 0.0_rk
      largest = 0.0_rk
      ! So much that the layer in the rock holds as much when it is a tenth of the chain thick.
      held = 0.0_rk
      if (kind == given_supply) held = 0.1_rk*storage*thickness*length
      associate (n => chain%n, g => chain%conductance)
         do
            call chain%prepare(dt)
            rho = chain%stored(p(:n - 1))
            ! The face and the last node: balances, with the inner nodes eliminated.
            rows(1, :) = [held + dt*g(0)*(1.0_rk - chain%alpha(1)), -dt*g(0)*chain%beta(1)]
            rows(2, :) = [-dt*g(n - 1)*chain%alpha(n - 1), &
                          storage*chain%volume(n) + dt*g(n - 1)*(1.0_rk - chain%beta(n - 1))]
            rhs = [dt + held*face + dt*g(0)*rho(1), &
                   storage*chain%volume(n)*p(n) + dt*g(n - 1)*rho(n - 1)]
            if (kind == given_scalar) then
               rows(1, :) = [1.0_rk, 0.0_rk]
               rhs(1) = 1.0_rk
            end if
            rhs = [rows(2, 2)*rhs(1) - rows(1, 2)*rhs(2), rows(1, 1)*rhs(2) - rows(2, 1)*rhs(1)] &
                  /(rows(1, 1)*rows(2, 2) - rows(1, 2)*rows(2, 1))
            face = rhs(1)
            p = [chain%inner(rho, 0.0_rk, face, rhs(2)), rhs(2)]
            inflow = inflow + dt*g(0)*(face - p(1))
            time = time + dt
            width = sqrt(diffusivity*time)
            if (width > to*thickness) exit
            dt = dt*growth
            if (width < from*first_volume) cycle
            select case (kind)
            case (given_scalar)
               found = inflow
               exact = 2.0_rk*storage*length*width/sqrt(pi)
            case (given_flux)
               found = face
               exact = 2.0_rk*width/(conductivity*length)/sqrt(pi)
            case default
               found = face
               associate (s => storage*length*sqrt(diffusivity)/held)
                  exact = (2.0_rk*s*sqrt(time/pi) - 1.0_rk + erfc_scaled(s*sqrt(time)))/(held*s**2)
               end associate
            end select
            largest = max(largest, abs(found/exact - 1.0_rk))
         end do
         call checks%is_close(largest, 0.0_rk, tolerance, name)
         call checks%is_close(storage*dot_product(chain%volume, p)/inflow, 1.0_rk, 1.0e-9_rk, &
                              name//": balance")
      end associate
   end subroutine compare

end program test_coarse_chain
