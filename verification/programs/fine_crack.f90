!> A straight crack in a window whose edge carries the exact displacement of the infinite plane
!! (verification/crack_*): half-length a = 0.05 m, window 4a.
!!
!! Arguments: kind, angle to the x axis [degree], a/h, sectors of the rosettes, and for kind
!! "frictional" the fluid pressure [Pa] and the dilation angle [degree]. Kinds:
!!   tension     remote s_yy = 1 MPa, free faces                               (catalogue 1.1)
!!   pressure    fluid pressure 1 MPa on the faces                              (catalogue 3.3)
!!   frictional  closed, slipping under -20, -10 MPa, friction 0.5              (catalogue 3.1)
!!   slip        the faces' jump is given: elliptical slip of 10 um            (catalogue 3.6)
!! Intensities are in units of 1 MPa sqrt(pi a), of 1 MPa m^1/2 for kinds frictional and slip.
program fine_crack
   use base_kinds, only: degree => radians, ik, pi, rk
   use exact_cracks, only: centre_crack, uniform_field
   use fine_faces, only: face_conditions_t, face_jump, face_slip, loaded_everywhere
   use fine_loads, only: fine_loads_t, no_loads
   use fine_model, only: fine_model_t
   use verification_cracks, only: line_stress, mesh_window, rock, write_faces, write_tips
   use verification_files, only: finish, integer_argument, real_argument, text_argument
   use verification_meshes, only: network_of
   implicit none(type, external)

   real(rk), parameter :: a = 0.05_rk  ! half-length [m]
   real(rk), parameter :: megapascal = 1.0e6_rk
   type(fine_model_t) :: model
   type(fine_loads_t) :: loads
   type(face_conditions_t) :: conditions
   character(len=:), allocatable :: kind
   real(rk), allocatable :: displacement(:, :)
   real(rk) :: angle, h, scale
   real(rk) :: remote(3)  ! [Pa]
   real(rk) :: normal, shear  ! what the crack takes off its line [Pa]

   kind = text_argument(1)
   angle = real_argument(2)*degree
   h = a/real_argument(3)
 call mesh_window(network_of([2_ik], a*reshape([-cos(angle), -sin(angle), cos(angle), sin(angle)], &
                                             [2, 2])), 2.0_rk*a, h, 4.0_rk*h, integer_argument(4), &
                    model)
   loads = no_loads(model%mesh)
   conditions = loaded_everywhere(model%mesh)
   remote = 0.0_rk
   normal = 0.0_rk
   shear = 0.0_rk
   scale = megapascal*sqrt(pi*a)
   select case (kind)
   case ("tension")
      remote = [0.0_rk, megapascal, 0.0_rk]
      call line_stress(angle, remote, normal, shear)
   case ("pressure")
      normal = megapascal
      loads%fluid_pressure = megapascal
   case ("frictional")
      scale = megapascal
      call set_frictional(real_argument(5), tan(real_argument(6)*degree))
   case ("slip")
      scale = megapascal
      call set_slip(1.0e-5_rk)
   case default
      error stop "unknown kind of crack"
   end select
   call set_edge()
   call write_tips(model, conditions, loads, scale, displacement)
   call write_faces(model, displacement)
   call finish()

contains

   !> Exact displacements. The window's edge does not touch the crack, so it does not matter which
   !! side is meant on it.
   subroutine set_edge()
      real(rk) :: rotation(2, 2)
      integer(ik) :: node

      rotation = reshape([cos(angle), sin(angle), -sin(angle), cos(angle)], [2, 2])
      do node = 1, model%mesh%n_nodes
         associate (xy => model%mesh%xy(:, node))
            loads%boundary_displacement(:, node) = uniform_field(rock, remote, xy) &
          + matmul(rotation, centre_crack(rock, a, normal, shear, matmul(transpose(rotation), xy), &
                                                                                   .true.))
         end associate
      end do
   end subroutine set_edge

   !> Catalogue 3.1: drop of shear stress D = (tau - mu (s_n - p))/(1 + mu tan(psi)).
   subroutine set_frictional(pressure, dilation)
      real(rk), intent(in) :: pressure  !< [Pa]
      real(rk), intent(in) :: dilation  !< tan(psi)
      real(rk), parameter :: friction = 0.5_rk
      real(rk) :: contact, on_line(2)

      remote = [-20.0_rk, -10.0_rk, 0.0_rk]*megapascal
      call line_stress(angle, remote, on_line(1), on_line(2))
      shear = (on_line(2) - friction*(-on_line(1) - pressure))/(1.0_rk + friction*dilation)
      normal = dilation*shear
      contact = -on_line(1) - pressure + dilation*shear
      conditions%condition = face_slip
      conditions%dilation = dilation
      loads%traction(1, :) = friction*contact
      loads%traction(2, :) = -contact
      loads%fluid_pressure = pressure
   end subroutine set_frictional

   !> Catalogue 3.6: slip u0 sqrt(1 - (x/a)**2).
   subroutine set_slip(largest)
      real(rk), intent(in) :: largest  !< u0 [m]
      integer(ik) :: cell

      shear = rock%crack_modulus()*largest/(4.0_rk*a)
      conditions%condition = face_jump
      do cell = 1, model%mesh%fracture%n_cells
         loads%jump(1, :, cell) = largest*sqrt(max(0.0_rk, 1.0_rk - (model%mesh%face_s(:, cell)/a &
                                                                     - 1.0_rk)**2))
      end do
   end subroutine set_slip

end program fine_crack
