!> Blocks of a body that a fracture cuts in two: they stick, slide and separate exactly as they
!! should.
program test_coarse_blocks
   use base_kinds, only: ik, rk
   use coarse_fields, only: cell_stresses
   use coarse_model, only: coarse_model_t
   use coarse_state, only: state_t, step_report_t
   use contact_law, only: contact_law_t, state_open, state_slip, state_stick
   use mesh_types, only: mesh_t
   use sample_bodies, only: cut_square, equilibrate, load_sides, porous_body
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: young = 40.0e9_rk  !< [Pa]
   real(rk), parameter :: height = 2.0_rk  !< of the body [m]
   real(rk), parameter :: middle(2, 2) = reshape([0.0_rk, 1.0_rk, 2.0_rk, 1.0_rk], [2, 2])
   type(checks_t) :: checks
   type(step_report_t) :: report

   call test_sliding_block(contact_law_t(friction=0.6_rk, dilation=0.0_rk))
   call test_sliding_block(contact_law_t(friction=0.6_rk, dilation=0.1_rk))
   call test_sliding_block(contact_law_t(friction=0.0_rk, dilation=0.0_rk))
   call test_separating_block()
   call checks%finish()

contains

   !> Rock without Poisson effect and without coupling to the fluid, its lower side held, its upper
   !! side displaced: stress is uniform, sigma_yy = E times the strain, sigma_xy = G times the
   !! shear.
   function held_body(displacement, shear_stress) result(scene)
      real(rk), intent(in) :: displacement(2)  !< of the upper side [m]
      real(rk), intent(in) :: shear_stress  !< on the left and right sides [Pa]
      type(scene_t) :: scene

      scene = porous_body()
      scene%material%poisson = 0.0_rk
      scene%material%biot = 0.0_rk
      call load_sides(scene, [0.0_rk, 0.0_rk, shear_stress])
      scene%sides(3:4)%displacement_given(1) = .true.
      scene%sides(3:4)%displacement_given(2) = .true.
      scene%sides(4)%displacement = displacement
   end function held_body

   !> The upper half pressed down and pushed sideways: it sticks below the threshold, and above it
   !! the slip is what is left of the push, the shear stress the friction; either way, for a
   !! fracture drawn either way.
   subroutine test_sliding_block(law)
      type(contact_law_t), intent(in) :: law
      real(rk), parameter :: press = 1.0e-3_rk  !< [m]
      real(rk), parameter :: shear = 0.5_rk*young
      real(rk) :: push, slip, threshold
      integer :: direction, drawn

      threshold = law%friction*young*press/shear
      do direction = -1, 1, 2
         do drawn = -1, 1, 2
            if (threshold > 0.0_rk) then
               push = threshold*(1.0_rk - 1.0e-6_rk)
               call slide(law, direction*push, 0.0_rk, press, drawn, state_stick)
            end if
            push = threshold*1.000001_rk + merge(0.0_rk, 1.0e-4_rk, threshold > 0.0_rk)
            ! G (push - slip)/H = mu E (press + dilation slip)/H
            slip = (shear*push - law%friction*young*press)/(shear + law%friction*law%dilation*young)
            call slide(law, direction*push, direction*slip, press, drawn, state_slip)
            push = 3.0e-3_rk
            slip = (shear*push - law%friction*young*press)/(shear + law%friction*law%dilation*young)
            call slide(law, direction*push, direction*slip, press, drawn, state_slip)
         end do
      end do
   end subroutine test_sliding_block

   subroutine slide(law, push, slip, press, drawn, expected)
      type(contact_law_t), intent(in) :: law
      real(rk), intent(in) :: push, slip, press  !< push and slip to the right [m]
      integer, intent(in) :: drawn  !< 1: from left to right, -1: from right to left
      integer(ik), intent(in) :: expected
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: state
      real(rk), allocatable :: stresses(:, :)
      real(rk) :: pressure, stress

      stress = 0.5_rk*young*(push - slip)/height
      pressure = young*(press + law%dilation*abs(slip))/height
      call cut_square(checks, held_body([push, -press], stress), &
                      merge(middle, middle(:, 2:1:-1), drawn > 0), law, 1.0e-3_rk, mesh, model, &
                      state)
      call equilibrate(checks, model, mesh, 1.0_rk, state, report, "sliding block")
      call checks%is_true(all(state%contact == expected), "all cells stick, or all slip")
      ! Drawn from right to left, tau points to the left and the upper half is side +: neither the
      ! slip [u]_tau nor the traction f_tau changes its sign with both of these.
      call checks%is_close(maxval(abs(state%jump(2, :, :) - slip)), 0.0_rk, 1.0e-11_rk, "slip")
      call checks%is_close(maxval(abs(state%jump(1, :, :) - law%dilation*abs(slip))), 0.0_rk, &
                           1.0e-11_rk, "dilation")
      call checks%is_close(maxval(abs(state%traction(2, :, :) - stress)), 0.0_rk, 1.0_rk, &
                           "friction")
      call checks%is_close(maxval(abs(state%traction(1, :, :) + pressure)), 0.0_rk, 1.0_rk, &
                           "contact pressure")
      call checks%is_close(report%contact_residual, 0.0_rk, 1.0e-9_rk, "law of contact")
      allocate (stresses(3, mesh%n_cells))
      call cell_stresses(mesh, model%regions, state%tractions, stresses)
      call checks%is_close(maxval(abs(stresses - spread([0.0_rk, -pressure, stress], 2, &
                                                        mesh%n_cells))), 0.0_rk, 10.0_rk, &
                           "uniform stress on both sides")
   end subroutine slide

   !> The upper half lifted and moved sideways: no traction anywhere, the jump is the motion.
   subroutine test_separating_block()
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: state
      real(rk), parameter :: motion(2) = [0.7e-3_rk, 1.0e-3_rk]

      call cut_square(checks, held_body(motion, 0.0_rk), middle, contact_law_t(friction=0.6_rk, &
                                                                               dilation=0.1_rk), &
                      1.0e-3_rk, mesh, model, state)
      call equilibrate(checks, model, mesh, 1.0_rk, state, report, "separating block")
      call checks%is_true(all(state%contact == state_open), "all open")
      call checks%is_close(maxval(abs(state%traction)), 0.0_rk, 1.0e-2_rk, "no contact traction")
      call checks%is_close(maxval(abs(state%jump(1, :, :) - motion(2))), 0.0_rk, 1.0e-12_rk, &
                           "opening")
      call checks%is_close(maxval(abs(state%jump(2, :, :) - motion(1))), 0.0_rk, 1.0e-12_rk, &
                           "motion along the fracture")
      call checks%is_close(maxval(abs(state%aperture - 1.0e-3_rk - motion(2))), 0.0_rk, &
                           1.0e-12_rk, "aperture")
   end subroutine test_separating_block

end program test_coarse_blocks
